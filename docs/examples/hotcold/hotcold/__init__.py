"""A plug-in of tetrabench: the contestant hotcold, the scenario gradient, the model column, the workload reconstruction."""
