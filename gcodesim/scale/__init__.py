"""Work shared by many processes, here or on other machines, on Dask: what travels, who may work, what comes back."""
