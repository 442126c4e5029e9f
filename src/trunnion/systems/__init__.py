"""What analyses take: systems of equations, whoever wrote them."""
