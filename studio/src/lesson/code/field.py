from chordal.shapes import sphere

ball = sphere(1)
p = [(0, 0, 0.4), (2, 0, 0)]
print(ball(p))           # -0.6 inside, 1 outside: its distance
print(ball.gradient(p))  # and the way out
