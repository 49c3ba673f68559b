"""The certificate page of a model: storage, passivity and stability, with their figures."""
