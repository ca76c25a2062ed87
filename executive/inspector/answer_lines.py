"""Answers as plain lines: for files, for JUnit, for logs."""

from executive.inspector.past import PastRun
from executive.inspector.sentences import Answer


def answer_lines(run: PastRun, answer: Answer) -> list[str]:
    """Return an answer as lines of text, the headline first."""
    lines = [answer.headline, *(f"  {note}" for note in answer.notes)]
    for title, sentences in answer.sections:
        lines.append(f"{title}:")
        for sentence in sentences:
            if sentence.node is None:
                lines.append(f"  the runner: {sentence.text}")
            else:
                name, where = run.names.short(sentence.node), run.names.where(sentence.node)
                lines.append(f"  {name}: {sentence.text}  [{where}]")
    return lines
