"""What can be asked in words, and is done by files: planning and painting, whoever asks for it."""
