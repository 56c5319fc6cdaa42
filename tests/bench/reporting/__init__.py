"""What tests/bench/report is made of."""
