"""How exact tracking is on clips with a truth."""
