"""Where the machine is: odometry, inertial sensors, Kalman filters, recorded drives."""
