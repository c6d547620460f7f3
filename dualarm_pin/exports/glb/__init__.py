"""GLB files (binary glTF 2.0): a posture, or a motion as an animation of the joints.

trimesh writes the meshes and the tree of nodes, and reads the file back; it knows no animations, so
those are put into the file through its hook and taken out of it again here.
"""
