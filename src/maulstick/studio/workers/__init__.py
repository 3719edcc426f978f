"""Work that the studio does in other processes."""
