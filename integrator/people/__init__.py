"""Who is who: several people across the views and over time."""
