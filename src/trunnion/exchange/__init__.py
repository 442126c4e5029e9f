"""Lines as files of other programs: tables, a state space, openTorsion, Modelica."""
