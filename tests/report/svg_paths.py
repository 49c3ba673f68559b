"""Reads the paths of a drawing, independently of what writes them."""

import re


def corners_of(path: str) -> list[list[tuple[float, float]]]:
    """The corners of each part of a path of M, m, L, l and z, in pixels."""
    found: list[list[tuple[float, float]]] = []
    at, first = (0.0, 0.0), True
    for command, text in re.findall(r"([MmLlz])([^MmLlz]*)", path):
        numbers = [float(n) for n in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", text)]
        if command == "z":
            at = found[-1][0]
        for k in range(0, len(numbers), 2):
            moved = (at[0] + numbers[k], at[1] + numbers[k + 1])
            at = (numbers[k], numbers[k + 1]) if first or command in "ML" else moved
            if command in "Mm":
                found.append([])
            found[-1].append(at)
            first = False
    return found
