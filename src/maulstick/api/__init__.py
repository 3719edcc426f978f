"""The front door for Python: functions that take paths, pictures and arrays, and return what can be shown and saved."""
