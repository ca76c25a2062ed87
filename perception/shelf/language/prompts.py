"""What language models are asked about objects on shelves.

`{X}` stands for an object; the model is asked how likely each other object is to come next. One
wording favours what one corpus happens to say, so several are asked and their logarithms averaged.
They were written once, before any of them was scored, and speak of shelves, lists, likeness and
buying.
"""

from executive.core.errors import InputError

THESIS_PROMPT = "In a shelf, the {X} goes next to the"

PROMPTS = (
    THESIS_PROMPT,
    "Shopping list: {X},",
    "Similar products: {X} and",
    "Products of the same category: {X},",
    "On the store shelf, right beside the {X}, there is the",
    "Customers who bought {X} also bought",
)


def fill(prompt: str, name: str) -> str:
    """Return a prompt for one object.

    Raises:
        InputError: The prompt has no place for it.
    """
    if "{X}" not in prompt:
        raise InputError(f"prompt: got {prompt!r}; expected {{X}} where the object goes")
    return prompt.replace("{X}", name)
