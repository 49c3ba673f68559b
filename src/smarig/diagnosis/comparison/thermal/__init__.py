"""Records of wire temperature: how a hypothesis becomes a prediction of what the thermometer shows."""
