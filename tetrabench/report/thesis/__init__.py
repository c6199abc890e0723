"""The source beside today: its tables, its figures 10 and 11, and whether what it found still holds."""
