"""*UV > Cone Unwrap*: conformal unwrapping of meshes with as few cones as their shapes ask for."""

from . import operator


def register():
    """Called by Blender where the extension is enabled."""
    operator.register()


def unregister():
    """Called by Blender where the extension is disabled."""
    operator.unregister()
