def trace(f, eye, way, most=100):
    t = 0.0
    for step in range(most):
        value = f([e + t * w for e, w in zip(eye, way)])
        if value < 1e-4:
            return t, step
        t += value  # nothing is nearer, so this is safe
    return None
