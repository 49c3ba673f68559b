"""A constitutive model of the material from isobaric and isothermal records."""
