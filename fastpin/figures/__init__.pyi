from .convergence import plot_convergence as plot_convergence
from .cycles import plot_cycles as plot_cycles
from .notebook import result_html as result_html
from .notebook import state_html as state_html
from .states import drawn_places as drawn_places
from .sweep import plot_sweep as plot_sweep
from .tractions import plot_tractions as plot_tractions
