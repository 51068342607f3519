"""The paper's stages for one view: measures, facing, position, arms, legs (sections 2.4 and 3)."""
