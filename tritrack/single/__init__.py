"""Videos of one camera: tracked, drawn, retouched."""
