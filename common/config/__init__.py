"""The settings: frozen values with defaults; a TOML file only departs from them."""
