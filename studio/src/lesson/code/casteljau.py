def lerp(p, q, t):
    return [a + t * (b - a) for a, b in zip(p, q)]

def casteljau(points, t):
    while len(points) > 1:
        points = [lerp(p, q, t) for p, q in zip(points, points[1:])]
    return points[0]
