"""Films of one camera: followed, drawn, retouched."""
