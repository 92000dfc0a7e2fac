def side(a, b, p):  # twice the signed area: positive on the left
    return (b[0]-a[0]) * (p[1]-a[1]) - (b[1]-a[1]) * (p[0]-a[0])

def inside(a, b, c, p):
    signs = side(a, b, p), side(b, c, p), side(c, a, p)
    return min(signs) >= 0 or max(signs) <= 0
