"""Videos of one camera: followed, drawn, retouched."""
