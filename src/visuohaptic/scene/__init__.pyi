from .parameters import Scene as Scene
