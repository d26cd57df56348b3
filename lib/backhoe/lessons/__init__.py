"""What serves one lesson each: its exercises, its figures, its formulas as the sources print them.

`exercise` declares what an exercise is; `published` reads the printed tables. Formulas in a
lesson's `printed` are as printed, mistakes included: for study, never for the machine.
"""
