//! What the workspace tests share: the built program, scenes, scratch folders.
