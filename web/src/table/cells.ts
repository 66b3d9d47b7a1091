/** The fields of the table, by JSON pointer: what they show, and how the keyboard moves in them. */
import type { Cell, TableDocument } from '../api';
import { h } from '../dom';
import { COLUMNS, type Column, ownColumn } from './convention';

export type Field = HTMLInputElement | HTMLSelectElement;

/** Digits of a limit, which is shown in a narrow field, and of other cells. */
const DIGITS = { limit: 4, cell: 12 };
/** Longest text that a cell shows whole. */
const FITS = 7;

export class Cells {
  private readonly fields = new Map<string, Field>();

  constructor(
    private readonly callbacks: {
      /** Whether the table being typed is the robot of the page. */
      isEdited(): boolean;
      /** The meaning of a column is asked for. */
      explain(column: Column): void;
    },
  ) {}

  /** The field of a pointer such as `/joints/0/theta`. */
  get(pointer: string): Field | undefined {
    return this.fields.get(pointer);
  }

  add(pointer: string, field: Field): void {
    this.fields.set(pointer, field);
  }

  clear(): void {
    this.fields.clear();
  }

  /** A table cell with a new field in it. */
  create(
    pointer: string,
    label: string,
    changed: (value: string) => void,
    column?: Column,
  ): HTMLTableCellElement {
    const field = h('input', {
      type: 'text',
      inputmode: 'text',
      autocomplete: 'off',
      spellcheck: 'false',
      'aria-label': label,
      oninput: () => {
        field.dataset.typing = 'yes';
        changed(field.value);
      },
      onblur: () => delete field.dataset.typing,
      onfocus: () => {
        field.select();
        if (column) this.callbacks.explain(column);
      },
      onkeydown: (event) => this.step(event as KeyboardEvent, pointer),
    });
    this.add(pointer, field);
    return h('td', { class: column ? 'cell' : 'bound' }, field);
  }

  /** Show the values of a table. */
  fill({ joints, convention }: TableDocument): void {
    joints.forEach((row, k) => {
      const own = ownColumn(row, convention);
      for (const name of ['theta', 'd', 'a', 'alpha', 'r', 'b', 'gamma', 'ant'] as const) {
        this.write(`/joints/${k}/${name}`, row[name], DIGITS.cell);
      }
      for (const bound of ['lower', 'upper'] as const) {
        this.write(`/joints/${k}/limits/${bound}`, row.limits?.[bound], DIGITS.limit);
      }
      for (const column of COLUMNS[convention]) {
        this.get(`/joints/${k}/${column}`)?.classList.toggle('variable', column === own);
      }
    });
  }

  private write(pointer: string, value: Cell | undefined, digits: number): void {
    const field = this.get(pointer);
    if (!field || this.isTyping(field)) return;
    const text = cellText(value ?? '', digits);
    if (field.value !== text) field.value = text;
    const whole = String(value ?? '');
    field.title = whole.length > FITS ? whole : '';
  }

  /** Whether a field is being typed into: its text is in the state already. */
  private isTyping(field: Field): boolean {
    return (
      field === document.activeElement &&
      field.value !== '' &&
      field.dataset.typing === 'yes' &&
      this.callbacks.isEdited()
    );
  }

  /** Arrow keys and Enter go to the same column of the next row, or of the one before. */
  private step(event: KeyboardEvent, pointer: string): void {
    const isDown = event.key === 'ArrowDown' || event.key === 'Enter';
    if (!isDown && event.key !== 'ArrowUp') return;
    const next = pointer.replace(/\d+/, (k) => String(Number(k) + (isDown ? 1 : -1)));
    const field = this.get(next);
    if (!field) return;
    event.preventDefault();
    field.focus();
  }
}

/** A number to so many digits: 166.00306198325342 is shown as 166.003061983. */
function cellText(value: Cell, digits: number): string {
  return typeof value === 'number' ? String(Number(value.toPrecision(digits))) : value;
}
