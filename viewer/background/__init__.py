"""The picture without people: learnt from an empty opening, a plate, or a busy video."""
