import numpy as np

def blend(corners, values, p):
    weights = np.linalg.solve(np.vstack([np.transpose(corners), np.ones(3)]), [*p, 1])
    return weights, weights @ np.asarray(values)
