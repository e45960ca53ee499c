from .lookups import CHARTS as CHARTS
from .lookups import ChartFormula as ChartFormula
from .lookups import ChartQuantity as ChartQuantity
from .lookups import ChartValue as ChartValue
from .lookups import chart_formulas as chart_formulas
from .lookups import joint_values as joint_values
from .lookups import lookup as lookup
