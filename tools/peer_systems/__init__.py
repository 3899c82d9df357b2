"""What tools/peers is made of."""
