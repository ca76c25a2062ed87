"""Networks, and one folder for each trained version of them."""
