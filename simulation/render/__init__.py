"""Images of a simulated table: a small ray caster for capsules and boxes, and a grey sensor."""
