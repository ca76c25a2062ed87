"""The shelf cell with physics: a Kinova with the bluction tool before boxes that can topple."""
