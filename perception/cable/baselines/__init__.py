"""Systems from the literature, built anew from their descriptions, to compare with."""
