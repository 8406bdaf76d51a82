// Forward automatic differentiation: numbers that carry their derivatives with respect to N
// variables. FirstJet<N> has the gradient, SecondJet<N> the symmetric Hessian too. A function that
// is a template over its number type, evaluated with one of them, yields exact derivatives.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace surefoot::apps::jump {

template <int N>
struct FirstJet {
  using Gradient = Eigen::Matrix<double, N, 1>;

  double value = 0;
  Gradient gradient = Gradient::Zero();

  FirstJet() = default;
  FirstJet(double constant) : value(constant) {}
  static FirstJet variable(double at, int index) {
    FirstJet jet(at);
    jet.gradient[index] = 1.0;
    return jet;
  }
  // f(x) by the chain rule, from f, f' and f'' at x.
  static FirstJet chain(const FirstJet& x, double f, double df, double) {
    FirstJet jet(f);
    jet.gradient = df * x.gradient;
    return jet;
  }

  FirstJet& operator+=(const FirstJet& b) {
    value += b.value;
    gradient += b.gradient;
    return *this;
  }
  FirstJet& operator-=(const FirstJet& b) {
    value -= b.value;
    gradient -= b.gradient;
    return *this;
  }
  FirstJet& operator*=(double b) {
    value *= b;
    gradient *= b;
    return *this;
  }
  friend FirstJet operator*(const FirstJet& a, const FirstJet& b) {
    FirstJet jet(a.value * b.value);
    jet.gradient = a.gradient * b.value + b.gradient * a.value;
    return jet;
  }
};

template <int N>
struct SecondJet {
  using Gradient = Eigen::Matrix<double, N, 1>;
  using Hessian = Eigen::Matrix<double, N, N>;

  double value = 0;
  Gradient gradient = Gradient::Zero();
  Hessian hessian = Hessian::Zero();

  SecondJet() = default;
  SecondJet(double constant) : value(constant) {}
  static SecondJet variable(double at, int index) {
    SecondJet jet(at);
    jet.gradient[index] = 1.0;
    return jet;
  }
  static SecondJet chain(const SecondJet& x, double f, double df, double ddf) {
    SecondJet jet(f);
    jet.gradient = df * x.gradient;
    jet.hessian = df * x.hessian;
    jet.hessian.noalias() += ddf * x.gradient * x.gradient.transpose();
    return jet;
  }

  SecondJet& operator+=(const SecondJet& b) {
    value += b.value;
    gradient += b.gradient;
    hessian += b.hessian;
    return *this;
  }
  SecondJet& operator-=(const SecondJet& b) {
    value -= b.value;
    gradient -= b.gradient;
    hessian -= b.hessian;
    return *this;
  }
  SecondJet& operator*=(double b) {
    value *= b;
    gradient *= b;
    hessian *= b;
    return *this;
  }
  friend SecondJet operator*(const SecondJet& a, const SecondJet& b) {
    SecondJet jet(a.value * b.value);
    jet.gradient = a.gradient * b.value + b.gradient * a.value;
    jet.hessian = a.hessian * b.value + b.hessian * a.value;
    jet.hessian.noalias() += a.gradient * b.gradient.transpose();
    jet.hessian.noalias() += b.gradient * a.gradient.transpose();
    return jet;
  }
};

template <class T>
concept Jet = requires(T t) {
  t.gradient;
};

template <Jet T>
T operator+(T a, const T& b) {
  return a += b;
}
template <Jet T>
T operator-(T a, const T& b) {
  return a -= b;
}
template <Jet T>
T operator+(T a, double b) {
  a.value += b;
  return a;
}
template <Jet T>
T operator-(T a, double b) {
  return a + (-b);
}
template <Jet T>
T operator*(T a, double b) {
  return a *= b;
}
template <Jet T>
T operator*(double b, T a) {
  return a *= b;
}
template <Jet T>
T operator-(T a) {
  return a *= -1.0;
}
template <Jet T>
T sin(const T& x) {
  const double s = std::sin(x.value);
  return T::chain(x, s, std::cos(x.value), -s);
}
template <Jet T>
T cos(const T& x) {
  const double c = std::cos(x.value);
  return T::chain(x, c, -std::sin(x.value), -c);
}

// 1 / (1 + exp(-x)): a smooth step from 0 to 1.
inline double smooth_step(double x) { return 1.0 / (1.0 + std::exp(-x)); }
template <Jet T>
T smooth_step(const T& x) {
  const double s = smooth_step(x.value);
  const double ds = s * (1.0 - s);
  return T::chain(x, s, ds, ds * (1.0 - 2.0 * s));
}

}  // namespace surefoot::apps::jump
