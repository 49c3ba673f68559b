static double saturated(MODEL_memory *m, double u)
{
    double y = Y_LOWER;
    if (u > LOWER)
        y += between(key_above(u), key_below(LOWER));
    m->top = 1;
    m->U[0] = INFINITY;
    m->K[0] = m->Y[0] = 0.0;
    m->U[1] = LOWER;
    m->K[1] = key_below(LOWER);
    m->Y[1] = Y_LOWER;
    m->u = u;
    m->y = y;
    return y;
}

double MODEL_reset(MODEL_memory *m, int positive)
{
    m->forgotten = 0;
    return saturated(m, positive ? UPPER : LOWER);
}

static int pushed(MODEL_memory *m, int top, double key)
{
    if (top + 1 >= MODEL_EXTREMA + 2) {
        top -= 2;
        m->forgotten += 1;
    }
    top += 1;
    m->U[top] = m->u;
    m->K[top] = key;
    m->Y[top] = m->y;
    return top;
}

double MODEL_step(MODEL_memory *m, double u)
{
    int top = m->top;
    if (!(u > LOWER && u < UPPER)) {
        if (u != u)
            return m->y;
        u = u <= LOWER ? LOWER : UPPER;
        return u == m->u ? m->y : saturated(m, u);
    }
    if (u > m->u) {
        if (m->u < m->U[top]) /* the input was falling: the present point is a minimum */
            top = pushed(m, top, key_below(m->u));
        while (top > 2 && u >= m->U[top - 1])
            top -= 2;
        m->y = m->Y[top] + between(key_above(u), m->K[top]);
    } else if (u < m->u) {
        if (m->u > m->U[top]) /* the input was rising: the present point is a maximum */
            top = pushed(m, top, key_above(m->u));
        while (top > 2 && u <= m->U[top - 1])
            top -= 2;
        m->y = m->Y[top] - between(m->K[top], key_below(u));
    }
    m->u = u;
    m->top = top;
    return m->y;
}

/* --- inverse ------------------------------------------------------------------------------------------------ */

typedef struct {
    double key, y0, start, end, y_end; /* branch from an extremum with this key and output; its part and end */
    int up;
} segment;

static double output(const segment *s, double u)
{
    return s->up ? s->y0 + between(key_above(u), s->key) : s->y0 - between(s->key, key_below(u));
}

static double residual(const segment *s, double target, double u)
{
    double far = (s->up ? 1.0 : -1.0) * (output(s, u) - target), tiny = 1e-3 * ROUNDING;
    return -tiny < far && far < tiny ? 0.0 : far;
}

/* Regula falsi with Anderson and Bjorck's weights; every fourth step bisects. */
static double root(const segment *s, double target, double near, double far)
{
    double at_near = residual(s, target, near), at_far = residual(s, target, far), width, low, high, u, here, left;
    int count = 0, moved = 0;
    if (at_near >= 0)
        return near;
    if (at_far <= 0)
        return far;
    width = 1e-16 * fabs(far - near);
    while (fabs(far - near) > width) {
        count += 1;
        u = count % 4 ? far - at_far * (far - near) / (at_far - at_near) : 0.5 * (near + far);
        low = near < far ? near : far;
        high = near < far ? far : near;
        if (!(low < u && u < high)) {
            u = 0.5 * (near + far);
            if (u == near || u == far)
                break;
        }
        here = residual(s, target, u);
        if (here == 0.0)
            return u;
        if (here < 0) {
            if (moved == -1) {
                left = here / at_near;
                at_far *= left < 1.0 ? 1.0 - left : 0.5;
            }
            near = u;
            at_near = here;
            moved = -1;
        } else {
            if (moved == 1) {
                left = here / at_far;
                at_near *= left < 1.0 ? 1.0 - left : 0.5;
            }
            far = u;
            at_far = here;
            moved = 1;
        }
    }
    return far;
}

/* Number of the n rising places that are < u, or <= u. */
static int rank(const double *places, int n, double u, int right)
{
    int low = 0, high = n, middle;
    while (low < high) {
        middle = (low + high) / 2;
        if (right ? places[middle] <= u : places[middle] < u)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The k-th place strictly inside a segment, in the order of the move; count[0] receives their number. */
static double inside(const segment *s, const double *places, int n, int k, int *count)
{
    int first, last;
    if (s->end > s->start) {
        first = rank(places, n, s->start, 1);
        last = rank(places, n, s->end, 0);
    } else {
        first = rank(places, n, s->end, 1);
        last = rank(places, n, s->start, 0);
    }
    *count = last > first ? last - first : 0;
    if (k >= *count + (STEPS && s->start != s->end))
        k = -1; /* there is no such place */
    if (STEPS && s->start != s->end) { /* relays switch at once when the input leaves a threshold */
        *count += 1;
        if (k == 0)
            return nextafter(s->start, s->end);
        if (k > 0)
            k -= 1;
    }
    if (k < 0)
        return s->end;
    return s->end > s->start ? places[first + k] : places[last - 1 - k];
}

/* Neighbouring kinks (or nodes) around the target; MODEL_OUT_OF_RANGE if the segment does not reach it. */
static int bracket(const segment *s, double target, double *near, double *far)
{
    int n, k, low = 0, high;
    double before, progress, u, sign = s->up ? 1.0 : -1.0;
    if (MONOTONE) {
        if ((s->up ? target - s->y_end : s->y_end - target) > SLACK)
            return MODEL_OUT_OF_RANGE;
        (void)inside(s, KINKS, N_KINKS, 0, &n);
        high = n;
        while (low < high) {
            k = (low + high) / 2;
            if (residual(s, target, inside(s, KINKS, N_KINKS, k, &n)) >= -SLACK)
                high = k;
            else
                low = k + 1;
        }
        *near = low > 0 ? inside(s, KINKS, N_KINKS, low - 1, &n) : s->start;
        *far = low < n ? inside(s, KINKS, N_KINKS, low, &n) : s->end;
        return MODEL_FOUND;
    }
    (void)inside(s, NODES, N_NODES, 0, &n);
    *near = s->start;
    before = (output(s, s->start) - target) * sign;
    for (k = 0; k <= n; k++) {
        int unused;
        u = k < n ? inside(s, NODES, N_NODES, k, &unused) : s->end;
        progress = (output(s, u) - target) * sign;
        if (progress - before < -ROUNDING)
            return MODEL_NOT_MONOTONE;
        *far = u;
        if (progress >= -SLACK)
            return MODEL_FOUND;
        *near = u;
        before = progress;
    }
    return MODEL_OUT_OF_RANGE;
}

/* Search one segment; MODEL_OUT_OF_RANGE: continue with the next one. */
static int searched(segment *s, double extremum, double y0, double target, double *u)
{
    double near = s->start, far = s->end;
    int found;
    s->key = s->up ? key_below(extremum) : key_above(extremum);
    s->y0 = y0;
    if (s->y_end != s->y_end)
        s->y_end = output(s, s->end);
    found = bracket(s, target, &near, &far);
    if (found == MODEL_FOUND)
        *u = STEPS ? far : root(s, target, near, far);
    else
        *u = found == MODEL_NOT_MONOTONE ? near : s->end;
    return found;
}

int MODEL_inverse(const MODEL_memory *m, double target, double *u)
{
    segment s;
    int k = m->top, found;
    double at = m->u, end;
    *u = m->u;
    if (!isfinite(target))
        return MODEL_NOT_A_NUMBER;
    if (fabs(target - m->y) <= SLACK)
        return MODEL_FOUND;
    s.up = target > m->y;
    end = m->y;
    if (at != m->U[k] && (at < m->U[k]) == s.up) { /* the input reverses: a new branch starts at the present point */
        s.start = at;
        s.end = m->U[k];
        s.y_end = m->Y[k];
        found = searched(&s, m->u, m->y, target, u);
        if (found != MODEL_OUT_OF_RANGE)
            return found;
        end = s.y_end;
        at = s.end;
        k -= 1;
    }
    for (; k >= 1; k -= 2) {
        s.start = at;
        s.end = k >= 2 ? m->U[k - 1] : s.up ? UPPER : LOWER;
        s.y_end = k >= 2 ? m->Y[k - 1] : NAN;
        found = searched(&s, m->U[k], m->Y[k], target, u);
        if (found != MODEL_OUT_OF_RANGE)
            return found;
        end = s.y_end;
        at = s.end;
    }
    *u = at;
    return fabs(target - end) <= ROUNDING ? MODEL_FOUND : MODEL_OUT_OF_RANGE;
}
