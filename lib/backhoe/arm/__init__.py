"""The arm: where its links are, what moves them, and the control that holds them."""
