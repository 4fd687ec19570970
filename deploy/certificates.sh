#!/bin/bash
# Makes the files named by the Zenoh configurations: a certificate authority in FOLDER (an existing one is kept), and for
# each HOST a folder FOLDER/HOST with ca.pem, certificate.pem and key.pem, to be copied to /etc/hingewise/tls on that host.
# HOST is the name or IPv4 address by which others reach it; it is also the common name of the certificate, which
# access_control lists. worker:NAME makes a certificate in FOLDER/NAME that can only connect: if it is stolen, it cannot
# be used to impersonate a coordinator. FOLDER/ca.key signs all certificates: keep it secret.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: certificates.sh FOLDER HOST|worker:NAME..." >&2
    exit 2
fi
folder=$1
shift
days=825
for given in "$@"; do
    if ! [[ ${given#worker:} =~ ^[A-Za-z0-9][A-Za-z0-9._-]*$ ]]; then
        echo "certificates.sh: $given: allowed: letters, digits, . _ and -, with worker: before it or not" >&2
        exit 2
    fi
done
umask 077
mkdir -p "$folder"
new_key=(-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes)

if [ ! -e "$folder/ca.key" ]; then
    openssl req -x509 "${new_key[@]}" -keyout "$folder/ca.key" -out "$folder/ca.pem" -days 3650 \
        -subj "/CN=Hingewise authority" \
        -addext "basicConstraints=critical,CA:TRUE" -addext "keyUsage=critical,keyCertSign,cRLSign" 2>/dev/null
fi

for given in "$@"; do
    host=${given#worker:}
    own=$folder/$host
    mkdir -p "$own"
    kind=DNS
    [[ $host =~ ^[0-9.]+$ ]] && kind=IP
    use=serverAuth,clientAuth
    [[ $given == worker:* ]] && use=clientAuth
    openssl req -new "${new_key[@]}" -keyout "$own/key.pem" -out "$own/request.pem" -subj "/CN=$host" 2>/dev/null
    extensions="subjectAltName=$kind:$host
basicConstraints=critical,CA:FALSE
keyUsage=critical,digitalSignature
extendedKeyUsage=$use"
    openssl x509 -req -in "$own/request.pem" -CA "$folder/ca.pem" -CAkey "$folder/ca.key" -CAcreateserial \
        -days "$days" -out "$own/certificate.pem" -extfile <(printf '%s\n' "$extensions") 2>/dev/null
    rm "$own/request.pem"
    cp "$folder/ca.pem" "$own/ca.pem"
    echo "$own"
done
