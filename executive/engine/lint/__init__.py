"""What is legal in a tree but surely wrong: one small rule for each way to be wrong."""
