"""Runs by other processes and on other machines: shares of a sweep, starts of an optimisation, folders that go on."""
