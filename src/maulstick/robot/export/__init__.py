"""Export of routines as files, for machines that other programs drive."""
