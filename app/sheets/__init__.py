"""Answers as tables: columns with headings and units, for spreadsheets and reports."""
