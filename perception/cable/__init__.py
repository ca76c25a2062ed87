"""One or more cables in a grey overhead image: where they run, how they cross, what is tied."""
