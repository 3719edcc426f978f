"""Jobs: planning, painting and learning as the command line, the studio and Python share them."""
