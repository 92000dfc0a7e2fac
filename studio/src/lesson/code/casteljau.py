def casteljau(points, t):
    if len(points) == 1:
        return points[0]
    lerp = lambda p, q: [a + t * (b - a) for a, b in zip(p, q)]
    return casteljau([lerp(p, q) for p, q in zip(points, points[1:])], t)
