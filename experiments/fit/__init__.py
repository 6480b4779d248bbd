"""How individuals choose, from what they chose: Bayesian fits of Eq. (1) and (2) to a table of trials."""
