"""What a student worked out, compared with what is right, and the slips that explain it."""
