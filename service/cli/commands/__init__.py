"""One file a command; the file is imported when its command is called."""
