"""Who may ask what, and how often: API keys, rate limits, headers."""
