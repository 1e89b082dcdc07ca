"""What stands in for people: simulated recordings in the formats of real devices."""
