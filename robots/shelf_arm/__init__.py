"""One arm with a bluction tool before a shelf: where it stands, and how it does what is asked."""
