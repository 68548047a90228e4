"""The physical simulator: a balancing robot in MuJoCo."""
